#!/bin/sh
# Makes the films of docs/materials.md again: docs/materials.sh [FLAGS OF phystalk …]. Needs img2webp (of libwebp).
#
# PHYSTALK names the program (target/release/phystalk), FILMS the folder that the films go to (docs/media/materials),
# WORK one for everything else (a new one, that is removed), EACH_S the seconds that a film may take (600).
# STEPS is "frames pack", or one of the two where frames are made on another machine than films: they lie in WORK/NAME/v1/frames.
set -eu
phystalk=${PHYSTALK:-target/release/phystalk}
films=${FILMS:-docs/media/materials}
work=${WORK:-$(mktemp -d)}
steps=${STEPS:-frames pack}
[ -n "${WORK:-}" ] || trap 'rm -rf "$work"' EXIT
mkdir -p "$films" "$work"

table='camera={ eye_m = [0.55, -1.3, 1.05], target_m = [0, 0, 0.62], fov_deg = 42 }'
floor='camera={ eye_m = [0.9, -1.9, 1.5], target_m = [0, 0, 0.32], fov_deg = 45 }'
side='camera={ eye_m = [1.9, 0.6, 1.5], target_m = [0, 0.3, 0.32], fov_deg = 45 }'
ahead='camera={ eye_m = [1.4, -2.0, 1.5], target_m = [0.5, -0.05, 0.3], fov_deg = 45 }'
tall='camera={ eye_m = [1.3, -2.7, 1.7], target_m = [0, 0, 0.75], fov_deg = 45 }'

# Its name, where it is seen from, what is said, and what else is set.
film() {
    name=$1 seen=$2 words=$3
    shift 3
    echo "$name: $words"
    case $steps in *frames*)
        timeout "${EACH_S:-600}" "$phystalk" exec builtin:demo -p "$words" --quiet --size 384x216 \
            --store "$work/store" --out "$work/$name" --set "$seen" "$@" || { echo "$name: no film"; return; } ;;
    esac
    # Every second frame: 25 a second.
    case $steps in *pack*)
        img2webp -loop 0 -lossy -q 40 -d 40 "$work/$name/v1/frames/"*[02468].png -o "$films/$name.webp" >/dev/null ;;
    esac
}

muscle='object.vase.material={ kind = "muscle", young_pa = 3e5, activation = { period_s = 0.8, most = 0.5 } }'

film jelly  "$table" "The vase is of jelly. Make it jump 5 cm." "$@"
film rubber "$ahead" "The vase is of rubber and is thrown 50 cm forward." "$@"
film muscle "$table" "It lasts 2 s." --set "$muscle" "$@"
film dough  "$tall"  "Turn the vase into dough and drop it from 30 cm." "$@"
film clay   "$tall"  "Turn the vase into clay and drop it from 1 m." "$@"
film mud    "$floor" "Turn the vase into mud." "$@"
film jam    "$floor" "Turn the vase into jam." "$@"
film sand   "$floor" "Turn the vase into sand." "$@"
film snow   "$tall"  "Turn the vase into snow and drop it from 1 m." "$@"
film water  "$floor" "Turn the vase into water." "$@"
film sph    "$floor" "Turn the vase into water of smoothed particles." "$@"
film honey  "$floor" "Turn the vase into honey." "$@"
film lava   "$floor" "Turn the vase into lava." "$@"
film wood   "$side"  "The vase is of wood. Push it hard to the left." "$@"
film parts  "$side"  "The lower half is stone. Push it to the left at 0.2 s." "$@"
film change "$floor" "Make the vase jump 20 cm, at 0.4 s it turns to sand." "$@"
