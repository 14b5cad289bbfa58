# SPDX-License-Identifier: BSD-3-Clause
# The package of npm: what `make wasm` makes, with entries for node and browsers, types and samples.
NPM := $(B)/npm
NPM_FILES := $(wildcard src/bindings/js/*.* src/bindings/js/NOTICE src/bindings/js/samples/*)

.PHONY: npm
npm: $(NPM)/dynpoint-$(VERSION).tgz ## the package of npm, build/npm/dynpoint-*.tgz, for browsers and node (make deps wasm light)

$(NPM)/package/package.json: $(NPM_FILES) LICENSE tools/packaging/npm_package.js $(B)/abi.json $(WASM)/dynpoint.wasm \
  $(WASM)/dynpoint_compile.wasm $(WASM)/dynpoint.js
	$(NODE) tools/packaging/npm_package.js $(WASM) $(B)/abi.json $(@D)

$(NPM)/dynpoint-$(VERSION).tgz: $(NPM)/package/package.json
	@rm -f $(NPM)/dynpoint-*.tgz
	cd $(<D) && npm pack --silent --no-update-notifier --logs-max=0 --pack-destination .. >/dev/null
