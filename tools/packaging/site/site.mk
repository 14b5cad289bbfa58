# SPDX-License-Identifier: BSD-3-Clause
# The site of the pages (docs/contributing.md): docs/ as it is, the C API by Doxygen, the Python API by autodoc, and the page
# with the core in it where it was built. Any warning is an error.
SITE := $(B)/docs
SITE_FROM := tools/packaging/site
DOCS_PYTHON ?= build/venv-docs/bin/python

$(SITE)/xml/index.xml: $(wildcard include/*.h include/dynpoint/*.h) $(SITE_FROM)/Doxyfile $(SITE_FROM)/header_filter.py
	@rm -rf $(@D) && mkdir -p $(@D)
	{ cat $(SITE_FROM)/Doxyfile; echo 'INPUT = include'; echo 'OUTPUT_DIRECTORY = $(@D)'; \
	  echo 'INPUT_FILTER = "$(PYTHON) -B $(SITE_FROM)/header_filter.py"'; } | doxygen -

.PHONY: docs
docs: $(SITE)/xml/index.xml python-parts $(B)/abi.json ## the site, build/docs/site/VERSION/index.html, with search and both APIs (make deps docs)
	@rm -rf $(SITE)/package && mkdir -p $(SITE)/package $(SITE)/site
	@cp -R src/bindings/python/dynpoint $(SITE)/package && cp $(PY)/parts/_dynpoint.abi3.so $(SITE)/package/dynpoint
	$(PYTHON) -B $(SITE_FROM)/stage.py $(B)/abi.json $(SITE)/source $(wildcard $(PAGE))
	VERSION='$(VERSION)' DOXYGEN_XML='$(abspath $(SITE)/xml)' TREE='$(CURDIR)' PYTHONPATH='$(abspath $(SITE)/package)' PYTHONDONTWRITEBYTECODE=1 \
	  $(DOCS_PYTHON) -m sphinx -q -W --keep-going -b html -c $(SITE_FROM) -d $(SITE)/doctrees $(SITE)/source $(SITE)/site/$(VERSION)
	@cp $(SITE_FROM)/to_version.html $(SITE)/site/index.html && sed -i 's/@VERSION@/$(VERSION)/g' $(SITE)/site/index.html
	@echo $(SITE)/site/$(VERSION)/index.html
