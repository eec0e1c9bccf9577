"""Designed controllers in; margins, coupled poles and where rounded numbers move the poles out."""
