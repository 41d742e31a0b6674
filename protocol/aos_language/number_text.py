"""Numbers as text."""


def is_number(text: str) -> bool:
    """Returns whether Python reads the text as a number."""
    try:
        float(text)
    except ValueError:
        return False
    return True
