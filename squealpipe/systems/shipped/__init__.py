"""Systems that come with the package, each a file like a user's."""
