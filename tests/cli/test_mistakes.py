"""Typing mistakes: one sentence, no traceback, and the advice leads to a result."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from click.testing import Result
from kit.kinds import bench, files, hammer, ramp_and_hold
from kit.shell import ran

from dashpot import workflow
from dashpot.extensions.materials.hyperelastic.fit import fit_hyperelastic
from dashpot.extensions.materials.hyperelastic.read import read_stress_strain
from dashpot.workflow.json_archive import to_json

pytestmark = pytest.mark.once

EXAMPLES = (
    "rod.csv", "loops.csv", "hit.csv", "cld_1.csv", "tension.csv", "biaxial.csv",
    "shaker_20mN.csv", "shaker_500mN.csv", "door_line.csv", "sweeps.csv",
)  # fmt: skip
FIT = {
    "schema": "dashpot/fit@2",
    "model": {"k_inf": 200.0, "arms": [{"k": 120.0, "tau": 0.5}, {"k": 18.0, "tau": 16.0}]},
}
NAMED = (
    '--column time="a" --column displacement="b" --column force="c" '
    '--units "time=s,displacement=mm,force=N"'
)
OF_MEANS = (
    '--column time="time" --column displacement="displacement mean" --column force="force mean"'
)
MEANS = (
    "not the recorded signals; export the raw time, displacement and force instead. If it is a "
    f"test of a seal, name its columns: {OF_MEANS}"
)
ROD = "--shape disc:20mm,20mm --density 1000 --mass 31.4g"
RIG = "--mass 104g --seals 2"
TWO = "shaker_20mN.csv shaker_500mN.csv"
LAW = "export law.json --to abaqus --unit-system SI --temperature 23degC"
CARD = "export master.json --to abaqus --form prony --unit-system SI --temperature 23degC"
DECK = "export fit.json --to csv --unit-system SI --temperature 23degC --length 100mm"

MISTAKES = (
    # which files
    ("fit none.csv", "none.csv: there is no such file or folder", "fit seal.csv --arms 1"),
    ("fit seel.csv", "Did you mean seal.csv?", "fit seal.csv --arms 1"),
    ("fit clipped.csv", "To write the example of that name: dashpot demo --files --all", ""),
    # what a newcomer types
    ("help", "Type: dashpot --help", "--help"),
    ("help fit", "Type: dashpot fit --help", "fit --help"),
    ("version", "Type: dashpot --version", "--version"),
    ("predict seal.csv", "as 'dashpot fit FILE -o fit.json' writes it",
     "fit seal.csv --arms 1 -o new.json"),
    (f"predict fit.json {RIG} --frequency 12Hz", "Leave out one of them",
     "predict fit.json --frequency 12Hz --seals 2"),
    ("predict fit.json --mass 104g --seal 2", "Did you mean --seals?", f"predict fit.json {RIG}"),
    ("fit seal.csv --order 1", "Did you mean --arms?", "fit seal.csv --arms 1"),
    (f"{DECK.replace('--unit-system', '--units')}", "Did you mean --unit-system?",
     f"{DECK} --allow not_identified"),
    ("gui", "Did you mean 'app'?", "app --help"),
    ("fit seal.csv --until 3s", "--until is an option of dashpot", ""),
    (f"compare hammer.csv fit.json {RIG}", f"Type: dashpot compare fit.json hammer.csv {RIG}",
     f"compare fit.json hammer.csv {RIG}"),
    ("predict fit.json --mass 104g --seals two", "'two' is no number", f"predict fit.json {RIG}"),
    ("app --port abc", "'abc' is no whole number", ""),
    ("fit seal.csv --column force", "write --column force=VALUE",
     "fit seal.csv --column force=3 --arms 1"),
    ("fit seal.csv --arms -3", "expected 'auto', 0, 1, 2, ...", "fit seal.csv --arms 1"),
    ("fit seal.csv --seals 2", "--seals is for an FRF, a hammer test", "fit seal.csv --arms 1"),
    ("fit hammer.csv --reject three", "the hits are 1, 2", ""),
    ("simulate ramp -o x.csv", "Known are relaxation, creep, impact and motion", ""),
    ("demo x", "unexpected extra argument (x)", ""),
    ("fit lab/seal.csv", "there is no folder lab", "fit seal.csv --arms 1"),
    ("predict fiit.json --mass 104g", "Did you mean fit.json?", f"predict fit.json {RIG}"),
    ("batch seals.csv -o lot", "Did you mean seal.csv?", ""),
    ("verify seal", "Did you mean seal.csv?", ""),
    ("fit", "Missing argument 'FILE...'", "fit seal.csv --arms 1"),
    ("fit .", "is a folder: use dashpot batch", ""),
    ("fit fit.json", "is a fit: use dashpot predict", f"predict fit.json {RIG}"),
    ("fit line.csv", "for dashpot predict", ""),
    ("fit warming.csv", "sweep the frequency", "fit dma.csv --arms 1"),
    ("fit seal.csv hammer.csv", "such as --mass 104g",
     "fit seal.csv hammer.csv --mass 104g --arms 2"),
    ("fit seal.csv tension.csv", "Fit them one by one", "fit seal.csv --arms 1"),
    ("fit seal.csv triangle.csv", "Fit them one by one", "fit triangle.csv"),
    ("fit hammer.csv frf.csv", "Fit them one by one", "fit frf.csv"),
    ("fit hammer.csv frf.csv --mass 104g", "Fit them one by one",
     "fit frf.csv --mass 104g --arms 1"),
    ("fit creep.csv seal.csv", "a creep test is fitted alone", "fit creep.csv --arms 1"),
    (f"fit {TWO} --mass 114.8g", "--amplitude 0.02N --amplitude 0.5N",
     f"fit {TWO} --mass 114.8g --amplitude 0.02N --amplitude 0.5N"),
    ("predict seal.csv --mass 104g", "as 'dashpot fit FILE -o fit.json' writes it",
     "fit seal.csv --arms 1 -o new.json"),
    ("compare fit.json", "what fit.json is compared with", f"compare fit.json hammer.csv {RIG}"),
    ("compare hammer.csv fit.json", "Type: dashpot compare fit.json hammer.csv",
     "compare fit.json hammer.csv"),
    ("compare fit.json base.csv", "give the mass (--mass)",
     ""),
    ("report hammer.csv", "For hits or an FRF alone: dashpot fit hammer.csv", "fit hammer.csv"),
    ("report dma.csv", "Type: dashpot fit dma.csv", "fit dma.csv"),
    ("report fit.json", "Use dashpot predict", f"predict fit.json {RIG}"),
    ("export seal.csv --to csv --unit-system SI", "as 'dashpot fit FILE -o fit.json' writes it",
     "fit seal.csv --arms 1 -o new.json"),
    ("batch", "dashpot batch tests/ -o LOT", "batch lotdir -o lot --quick --arms 1"),
    ("batch lotdir", "which folder to fill: -o LOT", "batch lotdir -o lot --quick --arms 1"),
    ("batch seal.csv -o lot --watch", "looks at one folder", "batch lotdir -o lot --dry-run"),
    ("batch lotdir -o lot --watch --dry-run", "leave one out", "batch lotdir -o lot --dry-run"),
    ("verify fit.json", "--project FOLDER", "report seal.csv --project kept"),
    # what is in them
    ("fit odd.csv", f"name its columns: {NAMED}. To see its columns: dashpot inspect odd.csv",
     f"fit odd.csv {NAMED}"),
    ("fit means.csv", f"one row per cycle ('displacement mean', 'force mean'), {MEANS}",
     f"fit means.csv {OF_MEANS}"),
    ("fit strained.csv", "A test of a seal has time, displacement and force. To see", ""),
    ("fit bare.csv", '--units "time=s,displacement=mm,force=N"',
     "fit bare.csv --units time=s,displacement=mm,force=N --arms 1"),
    ("fit seal.csv --column force=Kraft", "the columns are 1 'time [s]', 2 'displacement [mm]'",
     "fit seal.csv --column force=3 --arms 1"),
    ("fit seal.csv --column forse=3", "Did you mean 'force'?",
     "fit seal.csv --column force=3 --arms 1"),
    ("fit seal.csv --units kraft=N", "To see the columns: dashpot inspect seal.csv",
     "inspect seal.csv"),
    ("fit seal.csv --units force", 'write for example --units "force=N',
     "fit seal.csv --units force=N --arms 1"),
    ("fit seal.csv --units force=Nm", "'Nm' is a unit of", "fit seal.csv --units force=N --arms 1"),
    ("fit seal.csv --text-format decimal=komma", "expected '.' or ','",
     "fit seal.csv --text-format decimal=. --arms 1"),
    ("fit seal.csv --text-format encoding=zlib", "give --text-format encoding=utf-8",
     "fit seal.csv --text-format encoding=utf-8 --arms 1"),
    ("fit seal.csv --file-part cycle=9", "holds 1 loading",
     "fit seal.csv --file-part cycle=1 --arms 1"),
    ("fit seal.csv --file-part sheet=Foo", "leave it out", "fit seal.csv --arms 1"),
    ("fit seal.csv --rate 1kHz", "leave --rate out", "fit seal.csv --arms 1"),
    ("fit cld_1.csv --file-part cycle=9", "holds 4 cycles", "fit cld_1.csv --file-part cycle=4"),
    ("fit cld_1.csv cld_1.csv", "each specimen once", "fit cld_1.csv"),
    (("report odd.csv hammer.csv --mass 104g --column time=1,displacement=2,force=3 "
     "--units time=s,displacement=mm,force=N"), "--column odd.csv:time=1,displacement=2,force=3",
     ("report odd.csv hammer.csv --mass 104g --no-joint -o r.html "
     "--column odd.csv:time=1,displacement=2,force=3 --units time=s,displacement=mm,force=N")),
    # numbers and their units
    ("fit hammer.csv --mass 104", "for example '104g'", "fit hammer.csv --mass 104g --arms 1"),
    ("fit hammer.csv --mass 104g --mass 104g", "Give the mass of each file",
     "fit hammer.csv --mass 104g --arms 1"),
    ("fit seal.csv --temperature 23", "for example '23degC'",
     "fit seal.csv --temperature 23degC --arms 1"),
    ("fit seal.csv --temperature 23K", "is the unit degC or K",
     "fit seal.csv --temperature 23degC --arms 1"),
    ("fit seal.csv --length 100", "for example '100mm'", "fit seal.csv --length 100mm --arms 1"),
    ("fit seal.csv --length 100m", "mm or m?", "fit seal.csv --length 100mm --arms 1"),
    ("fit seal.csv --machine 0.5ms", "write --machine sync=VALUE",
     "fit seal.csv --machine sync=0.5ms --arms 1"),
    ("fit seal.csv --machine compliance=50um", "expected a unit of compliance, one of: um/N",
     "fit seal.csv --machine compliance=5um/N --arms 1"),
    ("fit hammer.csv --band 40:5Hz", "40 is not below 5Hz", "fit hammer.csv --band 5:40Hz"),
    ("fit hammer.csv --band 5Hz", "expected 'low:high'", "fit hammer.csv --band 5:40Hz"),
    ("fit frf.csv --prior damping=2.85 --mass 104g", "give 0.0285",
     "fit frf.csv --prior damping=0.0285 --mass 104g --arms 1"),
    ("fit hammer.csv --mass 104g --mass-sd 1kg", "check its unit",
     "fit hammer.csv --mass 104g --mass-sd 1g --arms 1"),
    ("predict fit.json", "--mass 104g", "predict fit.json --mass 104g"),
    ("predict fit.json --mass 104g --base-psd 1g", "expected a density in g^2/Hz",
     "predict fit.json --mass 104g --base-psd 0.01g^2/Hz"),
    ("plan --frequency 12.71", "for example '12.71Hz'", "plan --frequency 12.71Hz"),
    ("plan --frequency 12Hz --cold 0", "for example '0degC'", "plan --frequency 12Hz --cold 0degC"),
    ("plan --frequency 12Hz --arm-time 1ms", "--arm-stiffness 0.05N/mm",
     "plan --frequency 12Hz --arm-time 1ms --arm-stiffness 0.05N/mm"),
    # options that do not suit
    ("fit seal.csv --mass 104g", "--mass is for", "fit seal.csv --arms 1"),
    ("fit hammer.csv --arms 2", "such as --mass 104g, or leave it out",
     "fit hammer.csv --arms 2 --mass 104g"),
    ("fit hammer.csv --seals 2", "such as --mass 104g, or leave it out", "fit hammer.csv"),
    ("fit hammer.csv --relative", "leave out", "fit hammer.csv"),
    ("fit hammer.csv --reject 9", "the hits are 1, 2, 3", "fit hammer.csv --reject 3"),
    ("fit hammer.csv --window hann", "expected one of none", "fit hammer.csv --window none"),
    ("fit seal.csv hammer.csv --mass 104g --amplitude 1N", "Leave them out",
     "fit seal.csv hammer.csv --mass 104g --arms 2"),
    ("fit seal.csv --reference 23degC", "leave out --reference", "fit seal.csv --arms 1"),
    ("fit seal.csv --save-shifts s.csv", "leave out --save-shifts", "fit seal.csv --arms 1"),
    ("fit seal.csv --elastic by-depth", "at least two depths", "fit seal.csv --arms 1"),
    ("fit dma.csv --at-temperature 25degC", "leave --at-temperature out", "fit dma.csv --arms 1"),
    ("fit sweeps.csv --temperature 23degC", "--at-temperature takes one of them",
     "fit sweeps.csv --at-temperature 25degC"),
    ("predict fit.json --mass 104g --close 1m/s", "--close is for a door",
     "predict fit.json --mass 104g"),
    ("predict fit.json --mass 104g --relative", "add --base",
     "predict fit.json --mass 104g --relative --base"),
    ("predict fit.json --mass 104g --base --frf-type mobility", "leave one out",
     "predict fit.json --mass 104g --base"),
    ("predict fit.json --mass 104g --machine sync=1ms", "or leave it out",
     "predict fit.json --mass 104g"),
    ("predict fit.json --mass 104g --shape disc:20mm,20mm", "given to a material's modulus",
     "predict fit.json --mass 104g"),
    ("predict fit.json --mass 104g --frf-type mobilty", "Did you mean 'mobility'?",
     "predict fit.json --mass 104g --frf-type mobility"),
    ("compare frf.csv polar.csv --mass 104g", "--mass is for a fit", "compare frf.csv polar.csv"),
    # the newer kinds
    ("fit ball.csv", "--mass 5g", "fit ball.csv --mass 5g --model kelvin-voigt"),
    ("fit ball.csv --mass 5g --radius 5m", "Check its unit", "fit ball.csv --mass 5g --radius 5mm"),
    ("fit ball.csv ball.csv --mass 5g", "dashpot batch",
     "fit ball.csv --mass 5g --model kelvin-voigt"),
    ("fit hit.csv --mass 5g --radius 5mm --model ogden", "Known are auto, kelvin-voigt",
     "fit hit.csv --mass 5g --radius 5mm --model kelvin-voigt"),
    ("fit hammer.csv --radius 5mm", "add --kind indentation", "fit hammer.csv"),
    ("fit triangle.csv --compression 12mm", "at most 8 mm", "fit triangle.csv --compression 6mm"),
    ("fit triangle.csv --compression 6N", "expected a unit of length",
     "fit triangle.csv --compression 6mm"),
    ("fit triangle.csv --force-limits 1:2N", "a file for each, or leave", "fit triangle.csv"),
    ("fit triangle.csv --compression-limits 8:4mm", "8 is not below 4mm",
     "fit triangle.csv --compression 6mm --compression-limits 4:8mm"),
    ("fit triangle.csv --relaxation seal.csv", "as 'dashpot fit FILE -o fit.json' writes it",
     "fit seal.csv --arms 1 -o new.json"),
    ("fit tension.csv --test planar --test biaxial", "once for each file",
     "fit tension.csv --test planar"),
    ("fit tension.csv --test biaxal", "Did you mean 'biaxial'?", "fit tension.csv --test biaxial"),
    ("fit tension.csv --model mooney", "Did you mean 'mooney-rivlin'?",
     "fit tension.csv --model mooney-rivlin"),
    ("fit tension.csv --stretches 1.5:0.7", "such as 0.7:1.5",
     "fit tension.csv --stretches 0.7:1.5"),
    ("fit tension.csv --stretches 0.7", "such as 0.7:1.5", "fit tension.csv --stretches 0.7:1.5"),
    ("fit tension.csv --compression 3mm", "--compression is for", "fit tension.csv"),
    ("fit tension.csv --terms 9", "1<=x<=3", "fit tension.csv --model ogden --terms 1"),
    ("fit rod.csv --density 1000", "--shape disc:20mm,20mm --mass 31.4g", f"fit rod.csv {ROD}"),
    ("fit rod.csv --shape disk:20mm,20mm --density 1000 --mass 31.4g", "Did you mean 'disc'?",
     f"fit rod.csv {ROD}"),
    ("fit rod.csv --shape disc --density 1000 --mass 31.4g", "write --shape disc:VALUE",
     f"fit rod.csv {ROD}"),
    ("fit rod.csv --shape disc:20,20 --density 1000 --mass 31.4g", "for example '20mm'",
     f"fit rod.csv {ROD}"),
    ("fit rod.csv --shape disc:20mm --density 1000 --mass 31.4g", "expected 2: diameter, height",
     f"fit rod.csv {ROD}"),
    ("fit rod.csv --shape disc:20mm,20mm --density 1 --mass 31.4g", "such as 1100 of rubber",
     f"fit rod.csv {ROD}"),
    ("fit loops.csv --model ogden", "Known are auto, factor", "fit loops.csv --model additive"),
    ("fit loops.csv strain.csv", "one amplitude sweep at a time", "fit loops.csv"),
    ("fit loops.csv --resonance-amplitude 1N", "--resonance-amplitude is for", "fit loops.csv"),
    (f"fit {TWO} --mass 114.8g --amplitude 0.02N", "the amplitude of each FRF",
     f"fit {TWO} --mass 114.8g --amplitude 0.02N --amplitude 0.5N"),
    (f"fit {TWO} --amplitude 0.02N --amplitude 0.5N", "expected the mass (--mass)",
     f"fit {TWO} --mass 114.8g --amplitude 0.02N --amplitude 0.5N"),
    (f"fit {TWO} --mass 114.8g --amplitude 0.02 --amplitude 0.5", "for example '0.02N'",
     f"fit {TWO} --mass 114.8g --amplitude 0.02N --amplitude 0.5N"),
    ("predict fit.json --mass 104g --amplitude 1N", "Leave out --amplitude",
     "predict fit.json --mass 104g"),
    # the newest kinds
    ("fit creep.csv --load 1N", "--load is an option of dashpot simulate. Leave it out here",
     "fit creep.csv --arms 1"),
    ("fit creep.csv --method hold", "creep.csv is a creep test", "fit creep.csv --arms 1"),
    ("fit creep.csv --machine drift=1mN/s", "does not suit a creep test. Leave it out; it takes",
     "fit creep.csv --machine sync=1ms --arms 1"),
    ("fit held.csv --elastic by-depth", "held.csv is a creep test", "fit held.csv --arms 1"),
    ("fit compliance.csv dma.csv", "is fitted alone", "fit dma.csv --arms 1"),
    ("fit compliance.csv --arms two", "expected 'auto', 0, 1, 2", ""),
    ("fit modulus.csv --method hold", "is a relaxation modulus", "fit modulus.csv --arms 1"),
    ("fit modulus.csv seal.csv", "fit the other tests one by one", "fit modulus.csv --arms 1"),
    ("fit modulus.csv --model ogden", "Known are auto, maxwell and fractional",
     "fit modulus.csv --arms 1 --model maxwell"),
    ("fit modulus.csv --shape disc:20mm,20mm", "--shape is for", "fit modulus.csv --arms 1"),
    ("fit dma.csv --mass 104g", "dma.csv is a dynamic (DMA) sweep", "fit dma.csv --arms 1"),
    ("fit dma.csv --reference 25degC", "Of one temperature leave --reference out",
     "fit dma.csv --arms 1"),
    ("fit sweeps.csv --shift wfl", "Did you mean 'wlf'?", ""),
    ("fit sweeps.csv --vertical yes", "Known are auto, 1, T and free", ""),
    ("fit sweeps.csv --at-temperature 99degC", "the test has -25 degC",
     "fit sweeps.csv --at-temperature 25degC"),
    ("fit sweeps.csv --reference 99degC", "tested were", ""),
    ("fit master.csv --at-temperature 25degC", "leave --at-temperature out",
     "fit master.csv --arms 1"),
    ("fit strain.csv --amplitude 1N", "strain.csv is an amplitude sweep", "fit strain.csv"),
    ("fit strain.csv --model cubik", "Did you mean 'cubic'?", "fit strain.csv --model cubic"),
    ("fit triangle.csv --test compression", "--test is for stress over strain", "fit triangle.csv"),
    ("fit triangle.csv --length 100", "for example '100mm'", "fit triangle.csv --length 100mm"),
    ("fit triangle.csv --compression 50%", "'%' is a unit of strain",
     "fit triangle.csv --compression 6mm"),
    ("fit triangle.csv --compression-limits 4mm", "expected 'low:high'",
     "fit triangle.csv --compression 6mm --compression-limits 4:8mm"),
    ("fit triangle.csv --relaxation none.json", "none.json: there is no such file",
     "fit triangle.csv"),
    ("fit cld_1.csv loops.csv", "Fit them one by one", "fit cld_1.csv --file-part cycle=4"),
    ("fit tension.csv --poisson 0.5", "from 0 to below 0.5 of a foam", "fit tension.csv"),
    ("fit tension.csv --model hyperfoam", "give it (--poisson 0",
     "fit tension.csv --model hyperfoam --poisson 0"),
    ("fit hit.csv --mass 5", "for example '5g'", "fit hit.csv --mass 5g --model hertz"),
    ("fit hit.csv --mass 5g --radius 5", "for example '5mm'",
     "fit hit.csv --mass 5g --radius 5mm --model kelvin-voigt"),
    ("fit hit.csv --mass 5g --seals 2", "hit.csv is a rebound indentation",
     "fit hit.csv --mass 5g --model hertz"),
    ("fit rod.csv --shape block:20mm,20mm --density 1000 --mass 31.4g",
     "expected 3: length, width, height", f"fit rod.csv {ROD}"),
    ("fit rod.csv --density 1g/cm3 --shape disc:20mm,20mm --mass 31.4g",
     "is no plain number of kg/m^3, such as 1000", f"fit rod.csv {ROD}"),
    ("fit loops.csv --mass 104g", "loops.csv is a cyclic run", "fit loops.csv --model additive"),
    ("fit loops.csv --model kraus", "Known are auto, factor, additive",
     "fit loops.csv --model additive"),
    ("fit loops.csv seal.csv", "Fit them one by one", "fit seal.csv --arms 1"),
    (f"fit {TWO} --mass 114.8g --amplitude 20N --amplitude 500N", "a seal would move by 8.71 m",
     f"fit {TWO} --mass 114.8g --amplitude 0.02N --amplitude 0.5N"),
    (f"fit {TWO} --mass 114.8g --amplitude 0.02N --amplitude 0.5N --resonance-amplitude 0.1",
     "'0.1N'", ""),
    ("fit polar.csv --band 1-50Hz", "expected 'low:high'", ""),
    ("fit fatigue.csv --arms 2", "fatigue.csv is a cyclic run", ""),
    ("fit channels.csv", "name its columns", ""),
    ("predict law.json --mass 104g", "law.json is a fit of a hyperelastic law (use dashpot export)",
     ""),
    ("predict master.json --mass 104g", "Give its shape: --shape disc:20mm,20mm",
     "predict master.json --mass 104g --shape disc:20mm,20mm"),
    ("predict master.json --shape disc:20mm,20mm", "--mass 104g",
     "predict master.json --mass 104g --shape disc:20mm,20mm"),
    ("predict fit.json --mass 104g --sweep loops.csv", "give both, or neither",
     "predict fit.json --mass 104g"),
    ("predict fit.json --mass 104g --base-psd 0.01", "expected a density in g^2/Hz",
     "predict fit.json --mass 104g --base-psd 0.01g^2/Hz"),
    ("predict fit.json --mass 104g --temperature 20", "for example '20degC'", ""),
    ("predict fit.json --mass 104g --close 1.2", "for example '1.2m/s'", ""),
    ("compare law.json hammer.csv", "law.json is a fit of a hyperelastic law", ""),
    ("compare fit.json loops.csv", "loops.csv is a cyclic run", "compare fit.json hammer.csv"),
    ("report loops.csv hammer.csv", "Type: dashpot fit loops.csv", "fit loops.csv"),
    ("report creep.csv", "Type: dashpot fit creep.csv", "fit creep.csv --arms 1"),
    ("export law.json", ("add --bulk-modulus, 2000MPa is usual for solid rubber. The test "
     "temperature is not stated"), f"{LAW} --bulk-modulus 2000MPa"),
    (LAW, "add --bulk-modulus", f"{LAW} --bulk-modulus 2000MPa"),
    ("export law.json --to lsdyna --unit-system SI --temperature 23degC --bulk-modulus 2GPa",
     "needs --density, such as 1200", ""),
    ("export law.json --to nastran --unit-system SI", "expected one of abaqus", ""),
    ("export master.json", "--form prony", f"{CARD} --allow not_identified"),
    (CARD, "--allow NAME", f"{CARD} --allow not_identified"),
    ("export fit.json --to ansis", "Did you mean 'ansys'?", ""),
    ("plan --frequency 12Hz --seal law.json", "is a fit of a hyperelastic law", ""),
    ("plan --frequency 12Hz --depth 8", "for example '8mm'", "plan --frequency 12Hz --depth 8mm"),
    ("simulate cld -o x.csv", "Known are relaxation, creep, impact and motion", ""),
    ("simulate creep --load 1 -o x.csv", "for example '1N'",
     "simulate creep --load 1N --hold 3s -o sim.csv"),
    ("verify none", "dashpot report --project FOLDER", ""),
    # what is written, and where
    ("fit seal.csv -o seal.csv", "give the output another name",
     "fit seal.csv --arms 1 -o new.json"),
    ("fit seal.csv -o fit.pdf", "written as .json", "fit seal.csv --arms 1 -o new.json"),
    ("fit seal.csv --plot fit.bmp", ".pdf, .png or .svg", "fit seal.csv --arms 1 --plot fit.svg"),
    ("report seal.csv -o r.pdf", "written as .html", "report seal.csv -o r.html"),
    ("inspect seal.csv --save lab.json", "written as .toml", "inspect seal.csv --save lab.toml"),
    ("inspect seal.csv --profile seal.csv", "not a profile", "inspect seal.csv"),
    ("predict fit.json --mass 104g -o f.uff", "written as .csv, .json or .html",
     "predict fit.json --mass 104g -o f.csv"),
    # all that is missing at once
    ("export fit.json", "Name the solver: --to nastran", f"{DECK} --allow not_identified"),
    ("export fit.json --unit-system SI", "give --temperature 23degC",
     f"{DECK} --allow not_identified"),
    ("export fit.json --to csv", ("add --unit-system, one of SI, mm-t-s, mm-kg-ms, in-lbf-s. "
     "The test temperature is not stated"), f"{DECK} --allow not_identified"),
    ("export fit.json --to csv --temperature 23degC --length 100mm --allow all",
     "add --unit-system, one of SI", f"{DECK} --allow all"),
    (DECK, "--allow", f"{DECK} --allow not_identified"),
    (f"{DECK} --allow all --form cards", "expected one of frequency, arms",
     f"{DECK} --allow all --form arms"),
    ("simulate relaxation", "Missing option '-o'", "simulate relaxation --hold 3s -o sim.csv"),
    ("simulate", "Known are relaxation, creep, impact and motion", ""),
    ("record", "Known are simulated, serial and replay", ""),
    ("plan", "matters, e.g. 12.71Hz", "plan --frequency 12.71Hz"),
    ("simulate relaxation -o x.json", "written as .csv or .txt",
     "simulate relaxation --hold 3s -o sim.csv"),
    ("simulate motion -o x.csv", "simulate motion --follow FILE",
     "simulate motion --follow seal.csv -o sim.csv"),
    ("simulate relaxation --misaligned 2deg -o x.csv", "Add --gauges",
     "simulate relaxation --hold 3s --misaligned 2deg --gauges -o sim.csv"),
    ("simulate impact --seal fit.json -o x.csv", "add --mass",
     "simulate impact --seal fit.json --mass 104g --hits 2 -o sim.csv"),
    ("plan --frequency 12Hz --seal papper", "Did you mean 'paper'?",
     "plan --frequency 12Hz --seal paper"),
    ("record --driver replay -o x.csv", "add --from FILE", ""),
    ("record --driver serial -o x.csv", "add --port", ""),
    ("demo --all", "Add --files", "demo --files -o shown"),
)  # fmt: skip
"""What is typed, what must be said of it, and what is typed by who heeds that."""


def crept() -> str:
    """A dead weight that was on before the record began: no word of creep is in it."""
    rows = ((t, 3 + 1.5 * (1 - math.exp(-t / 4))) for t in range(40))
    return "\n".join(
        ["time [s],displacement [mm],force [N]", *(f"{t},{x:.6f},1.5" for t, x in rows)]
    )


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a small file of each kind, and some that leave much open."""
    folder = tmp_path_factory.mktemp("mistakes")
    for name, (text, _) in files().items():
        (folder / name).write_text(text, encoding="utf-8")
    for name in EXAMPLES:
        (folder / name).write_text(workflow.EXAMPLES[name](), encoding="utf-8")
    (folder / "fit.json").write_text(json.dumps(FIT))
    of_rubber = {"k_inf": 2e6, "arms": [{"k": 1e6, "tau": 0.5}]}
    fitted = {**FIT, "unit": "Pa", "model": of_rubber}
    (folder / "master.json").write_text(json.dumps(fitted))
    law = fit_hyperelastic([read_stress_strain(folder / "tension.csv", "uniaxial")])
    (folder / "law.json").write_text(to_json(law))
    (folder / "held.csv").write_text(crept())
    seal = bench(ramp_and_hold(), head="time [s],displacement mean [mm],force mean [N]")
    head, *rows = seal.splitlines()
    with_errors = [f"{head},force SD [N]", *(f"{row},0.001" for row in rows)]
    (folder / "means.csv").write_text("\n".join(with_errors))
    creeping = "\n".join(f"{t},{1 - 0.5 ** (1 + t):.6f}" for t in range(40))
    (folder / "strained.csv").write_text("time [s],strain [%]\n" + creeping)
    (folder / "odd.csv").write_text(bench(ramp_and_hold(), head="a,b,c"))
    (folder / "bare.csv").write_text(bench(ramp_and_hold(), head="time,displacement,force"))
    (folder / "channels.csv").write_text(hammer("ch1,ch2,ch3"))
    (folder / "lotdir").mkdir()
    (folder / "lotdir" / "one.csv").write_text(bench(ramp_and_hold()))
    return folder


@pytest.fixture(scope="module")
def once() -> Callable[[str], Result]:
    """A line is run once: many mistakes lead to the same one."""
    return cache(lambda line: ran(*shlex.split(line)))


@pytest.fixture
def does(
    lab: Path, once: Callable[[str], Result], monkeypatch: pytest.MonkeyPatch
) -> Callable[[str], Result]:
    """What a line does in the laboratory's folder."""
    monkeypatch.chdir(lab)
    return once


def test_there_are_many() -> None:
    assert len({typed for typed, *_ in MISTAKES}) == len(MISTAKES)
    assert len(MISTAKES) > 190


@pytest.mark.parametrize(
    ("typed", "message", "obeyed"), MISTAKES, ids=[mistake[0] for mistake in MISTAKES]
)
def test_a_mistake_is_answered_with_what_to_do(
    does: Callable[[str], Result], typed: str, message: str, obeyed: str
) -> None:
    wrong = does(typed)
    assert wrong.exit_code == 2, wrong.output
    assert wrong.stdout == ""
    assert "Traceback" not in wrong.stderr
    assert message in " ".join(wrong.stderr.split())
    if obeyed:
        writes = any(word in obeyed for word in (" -o ", "--plot", "--save ", "--project"))
        more = " --overwrite" if writes and not obeyed.startswith("batch") else ""
        right = does(obeyed + more)
        assert right.exit_code == 0, right.output
