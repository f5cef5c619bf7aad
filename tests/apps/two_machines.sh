#!/usr/bin/env bash
# Four processes of `veridyn` on two machines that share no folder give the bytes of one process. The machines are network
# namespaces with addresses of their own; the second has its own host name and its own, empty, working folder. mpirun
# reaches it as it reaches any machine, by a remote shell: here `ip netns exec`.
# usage: two_machines.sh PROGRAM SOURCES
set -euo pipefail
program=$1 sources=$2

skip() { echo "skipped: $1"; exit 0; }
[ "$(id -u)" -eq 0 ] || skip "only root makes network namespaces"
command -v ip >/dev/null || skip "there is no ip (package iproute2)"
command -v mpirun >/dev/null || skip "there is no mpirun (package openmpi-bin)"
# Whoever runs in a container may be root without the right to.
here=veridyn-$$-a there=veridyn-$$-b
ip netns add "$here" 2>/dev/null || skip "network namespaces cannot be made here"
work=$(mktemp -d) aside=$(mktemp -d)
trap 'ip netns del "$here"; ip netns del "$there" 2>/dev/null || true; rm -rf "$work" "$aside"' EXIT
ip netns add "$there"
ip -n "$here" link add veridyn0 type veth peer name veridyn0 netns "$there"
ip -n "$here" addr add 10.213.7.1/24 dev veridyn0
ip -n "$there" addr add 10.213.7.2/24 dev veridyn0
for machine in "$here" "$there"; do
  ip -n "$machine" link set lo up
  ip -n "$machine" link set veridyn0 up
done

# The remote shell: `agent ADDRESS COMMAND...`. The working folder of the second machine is an empty one of its own; what is
# there in the end is listed for this script.
cat >"$aside/agent" <<END
#!/bin/sh
shift
exec ip netns exec $there unshare --mount --uts sh -c '
  hostname veridyn-b
  exec 3>>$aside/left
  mount -t tmpfs tmpfs $work && cd $work || exit 1
  sh -c "\$*"
  code=\$?
  find $work -mindepth 1 >&3
  exit \$code' agent "\$@"
END
chmod +x "$aside/agent"

export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
on_both() {
  ip netns exec "$here" mpirun --oversubscribe --host 10.213.7.1:2,10.213.7.2:2 --wdir "$work" \
    --mca plm_rsh_agent "$aside/agent" --mca oob_tcp_if_include veridyn0 --mca btl_tcp_if_include veridyn0 "$@"
}
# Is it true that these are two machines?
on_both sh -c 'echo "$OMPI_COMM_WORLD_RANK $(hostname) $(ip -4 -o addr show veridyn0 | grep -o "10.213.7.[0-9]*/" )"' | sort >"$work/machines"
if [ "$(cut -d " " -f 3 "$work/machines" | tr -d "\n")" != 10.213.7.1/10.213.7.1/10.213.7.2/10.213.7.2/ ]; then
  cat "$work/machines"
  echo "the processes are not on two machines"
  exit 1
fi
rm "$work/machines"

compare() {
  local name=$1
  shift
  "$program" "$@" --quiet --out "$work/$name-alone"
  on_both "$program" "$@" --quiet --out "$name-four" --checkpoint "$name-kept"
  local file
  for file in $(cd "$work/$name-alone" && ls -- *.csv estimate.json 2>/dev/null | grep -v evaluations.csv); do
    cmp "$work/$name-alone/$file" "$work/$name-four/$file"
    echo "the same: $name $file"
  done
}
arm=$sources/examples/studies/muscle
compare sensitivity sensitivity "$arm/arm_sensitivity.toml"
compare search identify "$arm/profile_arm.toml" --set identify.advice=false \
  --set 'identify.profiles=["triceps_long.optimal_fiber_length"]' --set 'identify.posterior={walkers=10,steps=20,effective=10}'
if [ -s "$aside/left" ]; then
  echo "the second machine has files: $(cat "$aside/left")"
  exit 1
fi
echo "four processes on two machines give the bytes of one"
