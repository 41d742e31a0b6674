"""What every robot and every world is made of: time, bodies, arm, gripper, base, camera, faults."""
