"""Probabilities for people."""

_ROUNDING = 1e-12


def chance_text(probability: float) -> str:
    """Three decimals; what is not certain, beyond rounding, is never shown as certain."""
    if _ROUNDING < probability < 0.0005:
        return "<0.001"
    return ">0.999" if 0.9995 <= probability < 1 - _ROUNDING else f"{probability:.3f}"
