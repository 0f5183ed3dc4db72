"""The two forms of the engine: the marked functions as they are, and the same functions as C.

`translation` writes all marked functions into one file of C, `making` has a compiler build it, `compiled` calls it, and
`interpreted` calls the functions themselves over lists. Only the standard library is needed to make the C form.
"""
