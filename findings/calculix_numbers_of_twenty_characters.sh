#!/usr/bin/env bash
# CalculiX: a number of 21 characters is cut to 20, and its exponent with it.
#
# Expected: a number between two commas may have any number of digits, as in Abaqus, whose syntax
#   CalculiX reads; what is too long is refused.
# Happens: 5.202123456789012e-05, the mass of a block of 52 g in tonnes with all the digits of a
#   double, is read as 5.202123456789012e-0, that is 5.2 tonnes. Exit status 0; the one warning is
#   that of any deck without a solid. With one digit more the cut number ends in "e-" and is
#   refused; with one digit less it is right.
# Matters: most doubles below 1e-4 have 20 to 22 characters if a script writes all their digits,
#   and masses in tonnes, densities in t/mm^3 and compliances are such numbers. The sag of a block under
#   its weight comes out as 5 km. Write at most ten digits.
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
sag() {                                     # of a mass on a spring of 10 N/mm, under its weight
    cat > block.inp <<DECK
*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
*ELEMENT, TYPE=SPRING2, ELSET=SEAL
1, 1, 2
*SPRING, ELSET=SEAL
1, 1
10.
*ELEMENT, TYPE=MASS, ELSET=BLOCK
2, 2
*MASS, ELSET=BLOCK
$1
*BOUNDARY
1, 1, 3
2, 2, 3
*STEP
*STATIC
*DLOAD
BLOCK, GRAV, 9810., 1., 0., 0.
*NODE PRINT, NSET=ALL
U
*END STEP
DECK
    root/usr/bin/ccx -i block > log.txt && awk '$1 == 2 {print $2}' block.dat
}
{ root/usr/bin/ccx -v || true; } | grep Version
short="$(sag 5.20212345678901e-05)"
long="$(sag 5.202123456789012e-05)"
other="$(sag 0.00005202123456789012)"
echo "mass 5.20212345678901e-05 t,    20 characters: sag $short mm"
echo "mass 5.202123456789012e-05 t,   21 characters: sag $long mm"
echo "mass 0.00005202123456789012 t,  22 characters: sag $other mm"
grep -i "warning\|error" log.txt
[ "$short" = 5.103283E-02 ] && [ "$other" = "$short" ] && [ "$long" = 5.103283E+03 ]
if sag 5.2021234567890123e-05; then echo "22 characters with an exponent are read now"; exit 1; fi
echo "mass 5.2021234567890123e-05 t,  22 characters: refused"
