# SPDX-License-Identifier: MIT
"""gnomon under the names that other packages call. Each module takes their objects by their attributes, and imports
nothing of theirs (docs/integrations.md)."""
