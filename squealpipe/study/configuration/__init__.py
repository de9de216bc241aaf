"""A study's configuration: sections, YAML, mistakes with a remedy."""
