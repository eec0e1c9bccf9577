"""Operating points, pole placement, schedules and margins: from a plant to a controller table."""
