"""What the report says, a chapter a file: stored results to blocks of content.

A chapter picks and formats; it computes no number.
"""
