"""Reads and writes words as XML, and reports faults that are the same in every language.

In: an element and what names mean around it. Out: a word of the vocabulary and diagnostics; and back: a word as an
element. All front ends read and write through it. Imports the vocabulary and the hall.
"""
