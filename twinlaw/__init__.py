"""The command line and the reports: nothing computes here."""
