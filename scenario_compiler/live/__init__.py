"""Runs in real time in a browser: a page that shows a run while it happens, and a person who drives in it.

In: a plan and its map. Out: a run folder like any other, with the person's inputs. Imports everything below but front
ends; only `server`, `cockpit` and `web` import starlette and uvicorn.
"""
