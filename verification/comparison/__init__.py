"""Several controllers and the papers' manoeuvres in; flights side by side, of plants off their design too, and figures of merit out."""
