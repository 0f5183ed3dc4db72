"""Words as XML text, in both directions, and the faults of text that every language shares.

In: an element and what names mean around it. Out: a word of the vocabulary and diagnostics; and back: a word as an
element. All front ends read and write through it. Imports the vocabulary and the hall.
"""
