"""The one exception whose message is written for the person at the keyboard."""


class InputError(ValueError):
    """Something the user gave cannot be used.

    The message is one sentence: what is wrong, where (file, key, value), and what to do about it.
    The command line prints it as it is and exits with code 2.
    """
