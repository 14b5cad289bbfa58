# SPDX-License-Identifier: BSD-3-Clause
# The page with the core in it (docs/page.md): the same in every configuration. Its meshes are made by the program.
PAGE := build/page/dynpoint.html

.PHONY: page
page: $(PAGE) ## build/page/dynpoint.html: touch an organ in a browser, from one file (make deps view wasm)

$(PAGE): $(wildcard tools/page/* tools/view/page/*.js tools/view/page/*.html tools/view/page/*.css) build/view/node_modules/three/package.json \
  LICENSE $(WASM)/dynpoint.wasm $(WASM)/dynpoint_compile.wasm $(WASM)/dynpoint.js | $(B)/dynpoint
	$(NODE) tools/page/make_touch_page.js build $(B)/dynpoint

build/view/node_modules/three/package.json:
	@echo 'three.js is missing: make deps view' >&2; exit 1
