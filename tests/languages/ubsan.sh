# SPDX-License-Identifier: BSD-3-Clause
# The native library of C# and Java with UBSan, build/ubsan/csharp/native/: whatever is undefined ends the program. run.sh
# of both call it in the release's check.
exec make -s csharp-native B=build/ubsan CFLAGS='-O1 -g1' CONFIG_CFLAGS='-fsanitize=undefined -fno-sanitize-recover=all'
