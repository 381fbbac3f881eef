#!/usr/bin/env bash
# CalculiX: of a spring whose stiffness is given over frequency, the last row holds for everything.
#
# Expected: the rows "stiffness, frequency" below *SPRING, as in Abaqus, whose syntax CalculiX
#   reads, hold each at its frequency; a static step takes the first, or the column is
#   refused. *DASHPOT of CalculiX itself reads "coefficient, frequency" and interpolates.
# Happens: the second field of *SPRING is passed over, and each row replaces the one before, as they
#   have the same temperature. The static stiffness is that of the highest frequency, and so is
#   every other. Exit status 0, no warning.
# Matters: a seal stiffens with frequency, and such tables go up to some 100 Hz, so a static sag and
#   the first modes are those of a seal that is far too stiff; the dampers beside it are right. Give
#   one stiffness for one band, or Maxwell arms.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
# CalculiX is no package of Python: that of Debian 12, with the libraries it needs, is unpacked here
apt-get -o APT::Sandbox::User=root download -qq calculix-ccx=2.20-1 libspooles2.2=2.2-14 \
    libarpack2 libblas3 liblapack3 libgfortran5 libquadmath0 libopenmpi3 libhwloc15 \
    libevent-core-2.1-7 libevent-pthreads-2.1-7
for package in *.deb; do dpkg-deb -x "$package" root; done
lib="$folder/root/usr/lib/x86_64-linux-gnu"
export LD_LIBRARY_PATH="$lib:$lib/blas:$lib/lapack" OMP_NUM_THREADS=1
stiffness() {                               # in a static step, of a spring with the rows given
    cat > seal.inp <<DECK
*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
*ELEMENT, TYPE=SPRING2, ELSET=SEAL
1, 1, 2
*SPRING, ELSET=SEAL
1, 1
$1
*BOUNDARY
1, 1, 3
2, 2, 3
*STEP
*STATIC
*CLOAD
2, 1, 1.
*NODE PRINT, NSET=ALL
U
*END STEP
DECK
    root/usr/bin/ccx -i seal > log.txt
    awk '$1 == 2 {printf "%.1f\n", 1 / $2}' seal.dat
}
{ root/usr/bin/ccx -v || true; } | grep Version
rising="$(stiffness $'100., 0.\n200., 10.\n400., 200.')"
falling="$(stiffness $'400., 200.\n200., 10.\n100., 0.')"
echo "rows 100 at 0 Hz, 200 at 10 Hz, 400 at 200 Hz: static stiffness $rising"
echo "the same rows the other way round:             static stiffness $falling"
! grep -i "warning\|error" log.txt
[ "$rising" = 400.0 ] && [ "$falling" = 100.0 ]
