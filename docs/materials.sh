#!/bin/sh
# Makes the films of docs/materials.md again: docs/materials.sh [FLAGS OF phystalk …]. Needs img2webp (of libwebp).
#
# PHYSTALK names the program (target/release/phystalk), FILMS the folder that the films go to (docs/media/materials),
# WORK one for everything else (a new one, that is removed).
set -eu
phystalk=${PHYSTALK:-target/release/phystalk}
films=${FILMS:-docs/media/materials}
work=${WORK:-$(mktemp -d)}
[ -n "${WORK:-}" ] || trap 'rm -rf "$work"' EXIT
mkdir -p "$films" "$work"

table='camera={ eye_m = [0.55, -1.3, 1.05], target_m = [0, 0, 0.62], fov_deg = 42 }'
floor='camera={ eye_m = [0.9, -1.9, 1.5], target_m = [0, 0, 0.32], fov_deg = 45 }'

# Its name, where it is seen from, what is said, and what else is set.
film() {
    name=$1 seen=$2 words=$3
    shift 3
    echo "$name: $words"
    "$phystalk" exec builtin:demo -p "$words" --quiet --size 384x216 --store "$work/store" --out "$work/$name" --set "$seen" "$@"
    # Every second frame: 25 a second.
    img2webp -loop 0 -lossy -q 40 -d 40 "$work/$name/v1/frames/"*[02468].png -o "$films/$name.webp" >/dev/null
}

muscle='object.vase.material={ kind = "muscle", young_pa = 3e5, activation = { period_s = 0.8, most = 0.5 } }'

film jelly  "$table" "The vase is of jelly. Make it jump 5 cm." "$@"
film rubber "$floor" "The vase is of rubber and is thrown 50 cm forward." "$@"
film muscle "$table" "It lasts 2 s." --set "$muscle" "$@"
film dough  "$floor" "Turn the vase into dough and drop it from 30 cm." "$@"
film clay   "$floor" "Turn the vase into clay and drop it from 1 m." "$@"
film mud    "$floor" "Turn the vase into mud." "$@"
film jam    "$floor" "Turn the vase into jam." "$@"
film sand   "$floor" "Turn the vase into sand." "$@"
film snow   "$floor" "Turn the vase into snow and drop it from 1 m." "$@"
film water  "$floor" "Turn the vase into water." "$@"
film honey  "$floor" "Turn the vase into honey." "$@"
film lava   "$floor" "Turn the vase into lava." "$@"
film wood   "$floor" "The vase is of wood. Push it hard to the left." "$@"
film parts  "$table" "The lower half is stone. Push it to the left at 0.2 s." "$@"
film change "$floor" "Make the vase jump 20 cm, at 0.4 s it turns to sand." "$@"
