#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# rf-spy against a made-up java and made-up jars: what it starts, and what it says when one is missing.
#   spy_test.sh PATH_OF_RF_SPY
set -uo pipefail
spy=$1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
mkdir -p "$dir/bin" "$dir/jars" "$dir/nothing"
# shellcheck disable=SC2016 # the made-up java expands them
printf '#!/bin/sh\necho "$CLASSPATH|$*"\n' >"$dir/bin/java"
chmod +x "$dir/bin/java"
touch "$dir/jars/lcm.jar" "$dir/jars/jchart2d.jar" "$dir/types.jar"
export PATH="$dir/bin:$PATH" DISPLAY=:0 RF_SPY_JAR_DIRS="$dir/nothing:$dir/jars" RF_LCMTYPES_JAR="$dir/types.jar"
unset CLASSPATH
failed=0

# expect CODE PATTERN COMMAND...: exit code and a pattern in the output.
expect() {
  local code=$1 pattern=$2 output got
  shift 2
  output=$("$@" 2>&1)
  got=$?
  if [ "$got" = "$code" ] && [[ $output == *$pattern* ]]; then return; fi
  printf 'wanted exit %s and "%s" of: %s\ngot %s: %s\n' "$code" "$pattern" "$*" "$got" "$output" >&2
  failed=1
}

jars="$dir/jars/lcm.jar:$dir/jars/jchart2d.jar:$dir/types.jar"
options='-Djava.net.preferIPv4Stack=true -Xmx256m lcm.spy.Spy'
expect 0 "$jars|$options -l udpm://239.255.76.67:7668?ttl=0" "$spy"
expect 0 "-l udpm://239.255.76.67:7667?ttl=0" "$spy" --bus bulk
expect 0 "-l udpm://239.255.76.67:7000" "$spy" -l udpm://239.255.76.67:7000
expect 0 "$jars:/other.jar|" env CLASSPATH=/other.jar "$spy"
expect 0 "net.core.rmem_default" "$spy" --help
expect 2 "it must be bulk or state" "$spy" --bus images
expect 2 "unknown argument" "$spy" --nonsense
expect 3 "apt-get install default-jre" env PATH="$dir/nothing" "$BASH" "$spy"
expect 3 "apt-get install liblcm-java" env RF_SPY_JAR_DIRS="$dir/nothing" "$spy"
rm "$dir/jars/jchart2d.jar"
expect 3 "apt-get install libjchart2d-java" "$spy"
touch "$dir/jars/jchart2d.jar"
expect 3 "apt-get install default-jdk-headless" env RF_LCMTYPES_JAR="$dir/gone.jar" "$spy"
expect 3 "DISPLAY is not set" env -u DISPLAY "$spy"
exit $failed
