"""What a scene will do and cost: tasks and kernels of a step, memory, time step, redundant settings."""
