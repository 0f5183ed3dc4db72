"""The storyboard (triggers, conditions, running actions), and the step, the run and the sweep that use it."""
