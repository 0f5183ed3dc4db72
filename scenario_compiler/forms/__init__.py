"""The two forms of marked functions: interpreted over lists, and compiled to C over arrays.

`declaration` declares the containers of columns that the functions take. `translation` writes all marked functions to
one C file, `making` compiles it and `machine_code` loads it. `compiled` and `interpreted` are the two forms, which have
the same interface. This package does not know what the functions calculate: packages above it declare their containers,
mark their functions, and list in a module called `entries` the functions that are called from outside. Only the
standard library is needed to make the C form.
"""
