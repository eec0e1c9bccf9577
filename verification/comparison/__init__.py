"""Controllers side by side: the papers' manoeuvres, plants that are not as designed for, and figures of merit."""
