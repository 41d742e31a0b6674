"""The parts of every robot and every world: time, bodies, arm, gripper, base, camera, faults."""
