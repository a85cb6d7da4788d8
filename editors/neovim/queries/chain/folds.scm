[(machine) (tool) (job) (function) (profile) (tool_surface) (sample) (mill) (settings) (arguments) (vector)] @fold
