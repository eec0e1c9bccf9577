"""Families of sealed cases and their answers in; the law from what an answer was told to how often such answers are right out."""
