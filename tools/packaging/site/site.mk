# SPDX-License-Identifier: BSD-3-Clause
# The site of the pages (docs/contributing.md): docs/ as it is, the C API by Doxygen, the Python API by autodoc, other
# languages by their own tools where these are, and the page with the core in it where it was built. Any warning is an error.
SITE := $(B)/docs
SITE_FROM := tools/packaging/site
DOCS_PYTHON ?= build/venv-docs/bin/python

$(SITE)/xml/index.xml: $(wildcard include/*.h include/dynpoint/*.h) $(SITE_FROM)/Doxyfile $(SITE_FROM)/header_filter.py
	@rm -rf $(@D) && mkdir -p $(@D)
	{ cat $(SITE_FROM)/Doxyfile; echo 'INPUT = include'; echo 'OUTPUT_DIRECTORY = $(@D)'; \
	  echo 'INPUT_FILTER = "$(PYTHON) -B $(SITE_FROM)/header_filter.py"'; } | doxygen -

# Where TypeDoc and a linker of WebAssembly are, JavaScript too.
ifneq ($(filter docs,$(MAKECMDGOALS)),)
SITE_NPM := $(if $(wildcard build/typedoc/node_modules/typedoc/bin/typedoc),$(if $(shell command -v wasm-ld),$(B)/npm/package/package.json))
endif

.PHONY: docs
docs: $(SITE)/xml/index.xml python-parts $(B)/abi.json $(B)/csharp/generated/Native.cs crate-sources $(SITE_NPM) ## the site, build/docs/site/VERSION/index.html, with search and the APIs of C, Python and other languages (make deps docs)
	@rm -rf $(SITE)/package $(SITE)/site/$(VERSION) && mkdir -p $(SITE)/package $(SITE)/site
	@cp -R src/bindings/python/dynpoint $(SITE)/package && cp $(PY)/parts/_dynpoint.abi3.so $(SITE)/package/dynpoint
	@sh $(SITE_FROM)/languages.sh $(B) $(SITE)/made $(VERSION)
	$(PYTHON) -B $(SITE_FROM)/stage.py $(B)/abi.json $(SITE)/made $(SITE)/source $(wildcard $(PAGE))
	VERSION='$(VERSION)' DOXYGEN_XML='$(abspath $(SITE)/xml)' TREE='$(CURDIR)' PYTHONPATH='$(abspath $(SITE)/package)' PYTHONDONTWRITEBYTECODE=1 \
	  $(DOCS_PYTHON) -m sphinx -q -W --keep-going -b html -c $(SITE_FROM) -d $(SITE)/doctrees $(SITE)/source $(SITE)/site/$(VERSION)
	$(PYTHON) -B $(SITE_FROM)/versions.py $(SITE)/site
	@echo $(SITE)/site/$(VERSION)/index.html
