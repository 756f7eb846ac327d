"""What drives: functions of time, and laws that look at the motion."""
