"""The faults that the page shows to its user."""


class Fault(Exception):
    """One sentence for the user. `status`: of HTTP."""

    def __init__(self, sentence, status=400):
        super().__init__(sentence)
        self.status = status
