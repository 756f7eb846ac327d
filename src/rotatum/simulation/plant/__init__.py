"""What moves: joints and arms as bodies, springs and friction, integrated in time."""
