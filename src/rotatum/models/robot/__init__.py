"""Rigid arms: closed forms, and URDF files through pinocchio."""
