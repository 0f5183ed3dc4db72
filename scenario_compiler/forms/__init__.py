"""The two forms of marked functions: interpreted over lists, and compiled to C over arrays.

`declaration` says how the containers of columns are declared that the functions take. `translation` writes all marked
functions into one file of C, `making` has a compiler build it, `machine_code` loads it; `compiled` and `interpreted`
are the forms, which are called alike. What the functions calculate is not known here: rooms above declare their
containers and mark their functions, and list in a module called `entries` those that are called from outside. Only the
standard library is needed to make the C form.
"""
