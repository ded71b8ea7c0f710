#!/bin/sh
# A ball dropped on a plate, as a program: three numbers in, two numbers printed.
exec awk -v h="$1" -v e="$2" -v g="$3" 'BEGIN {
    t = sqrt(2 * h / g); v = sqrt(2 * h * g)
    for (n = 1; n <= 100000 && e < 1; n++) {
        v *= e
        if (v * v <= 2 * g * 1e-9) { printf "time %.17g\nbounces %d\n", t, n; exit }
        t += 2 * v / g
    }
    print "time inf\nbounces nan"
}'
