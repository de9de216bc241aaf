"""What several figures share: style, axes, panels."""
