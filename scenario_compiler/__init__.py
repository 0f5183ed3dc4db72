"""Declarative scenario compiler: conflicts written as XML become runs with a takeover and a report."""
