"""The papers' tables and figures, each as a program: ``rotatum reproduce``."""
