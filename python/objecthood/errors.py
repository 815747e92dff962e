"""What can go wrong. Every exception says what is wrong, where, and what to do."""


class ObjecthoodError(Exception):
    """Any error of this package."""


class InputError(ObjecthoodError, ValueError):
    """An array, camera or label image that cannot be used."""


class ParameterError(ObjecthoodError, ValueError):
    """A parameter that does not exist, or a value outside its range."""


class FileError(ObjecthoodError, OSError):
    """A file that cannot be read or written, or that breaks its format."""
