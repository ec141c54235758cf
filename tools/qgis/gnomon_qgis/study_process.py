# SPDX-License-Identifier: MIT
"""Runs gnomon-study in a process of its own; Cancel ends it."""

import os
import re
import shutil
import subprocess
import threading

from processing.core.ProcessingConfig import ProcessingConfig
from qgis.core import QgsProcessingException

PERCENT = re.compile(r"(\d+)%")


def program():
    """The path of gnomon-study: the environment variable GNOMON_STUDY, else the provider's setting."""
    named = os.environ.get("GNOMON_STUDY") or ProcessingConfig.getSetting("GNOMON_STUDY") or "gnomon-study"
    found = shutil.which(named)
    if found is None:
        raise QgsProcessingException(
            f"There is no program {named}. Install gnomon (pip install 'gnomon[study,weather,pocl]') into any Python "
            "environment, and name its bin/gnomon-study under Settings, Options, Processing, Providers, gnomon."
        )
    return found


def environment():
    """QGIS's own Python, GDAL and PROJ must not reach the program's."""
    ours = ("PYTHONHOME", "PYTHONPATH", "GDAL_DATA", "GDAL_DRIVER_PATH", "PROJ_LIB", "PROJ_DATA")
    return {key: value for key, value in os.environ.items() if key not in ours}


def run(arguments, feedback):
    """Raises QgsProcessingException with what the program says, or that it was cancelled."""
    command = [program(), *arguments]
    feedback.pushCommandInfo(" ".join(command))
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment(), text=True, bufsize=1,
        creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
    )
    is_over = threading.Event()
    watcher = threading.Thread(target=_end_when_cancelled, args=(process, feedback, is_over), daemon=True)
    watcher.start()
    lines = []
    for line in process.stdout:  # a progress bar ends its states by carriage returns, which are line ends here
        percent = PERCENT.search(line)
        if percent:
            feedback.setProgress(int(percent[1]))
        elif line.strip():
            lines.append(line.rstrip())
            feedback.pushConsoleInfo(lines[-1])
    process.stdout.close()
    code = process.wait()
    is_over.set()
    watcher.join()
    if feedback.isCanceled():
        raise QgsProcessingException("cancelled")
    if code != 0:
        raise QgsProcessingException("\n".join(lines[-3:]) or f"gnomon-study ended with code {code}")


def _end_when_cancelled(process, feedback, is_over):
    while not is_over.wait(0.2):
        if feedback.isCanceled():
            process.terminate()
            return
