"""Runs that take place in front of somebody: a page that shows one as it happens, and a person who drives in it.

In: a plan and its map. Out: a run folder like any other, with the person's inputs. Imports everything below but front
ends; starlette and uvicorn in `server` alone.
"""
