# SPDX-License-Identifier: BSD-3-Clause
# Python: the scene, with the package that tests/python/check.sh has installed (check.sh beside this folder calls it, when
# it is asked to).
site=$1/python/site
python=$1/venv-python/bin/python
if [ ! -d "$site/dynpoint" ] || [ ! -x "$python" ]; then
    echo "skip no package of Python was built (make deps python; sh tests/python/check.sh)"
    exit 0
fi
echo "touch python $(PYTHONPATH=$site PYTHONDONTWRITEBYTECODE=1 "$python" tests/languages/python/touch.py "$3")"
