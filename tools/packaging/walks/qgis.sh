# SPDX-License-Identifier: MIT
# In a bare Debian with QGIS, from the plugin's .zip and the wheel alone (clean_root.sh): a stranger takes the wheel into an
# environment, and the plugin runs all its algorithms in a headless QGIS (tools/qgis/check_in_qgis.sh).
walk=qgis
apt update
apt install qgis python3-qgis python3-venv pocl-opencl-icd
did "QGIS $(dpkg-query -W -f '${Version}' qgis) from Debian $(cat /etc/debian_version)"
python3 -m venv /venv
/venv/bin/pip --quiet install "$(echo /artefacts/gnomon-*.whl)[study,weather]"
mkdir -m 777 maps
as_stranger /artefacts/check_in_qgis.sh /venv/bin/gnomon-study maps /artefacts/gnomon-qgis.zip >said.txt 2>errors.txt ||
    { tail -n 30 said.txt errors.txt; exit 1; }
grep -q '^all is well' said.txt
cp maps/*.png /results
grep -v '^all is well' said.txt | while read -r line; do did "the plugin in a headless QGIS: $line"; done
