"""The four model levels of the paper's Table 1, one module each.

A1 keeps everything; A2, A3 and A4 each say what they drop and when that is valid.
"""
