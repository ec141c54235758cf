# SPDX-License-Identifier: MIT
"""The tests' device says what it is, so that a log shows what was tested."""

import gnomon


def pytest_report_header() -> str:
    try:
        return f"gnomon {gnomon.__version__} on {gnomon.use()!r}, driver {gnomon.use().description.driver_version}"
    except gnomon.DeviceNotFoundError as error:
        return f"gnomon {gnomon.__version__}, no device: {error}"
