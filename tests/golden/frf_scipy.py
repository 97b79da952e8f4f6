# Writes frf_scipy.txt, the reference of tests/host_sim/frf/cross_spectra_test.cpp. Run by hand, with SciPy 1.10.1 and NumPy 1.24.2:
#   python3 tests/golden/frf_scipy.py > tests/golden/frf_scipy.txt
import math

import numpy
import scipy
from scipy import signal

rate = 250.0
count = 300

# Two sines, a trend and uniform noise of a linear congruential generator; y is late, filtered and noisy.
state = 12345


def noise():
    global state
    state = (1103515245 * state + 12345) % 2**31
    return state / 2**30 - 1.0


x = numpy.array([math.sin(0.31 * n) + 0.5 * math.sin(1.7 * n + 0.2) + 0.004 * n + noise() for n in range(count)])
y = numpy.array([3.0 * x[max(n - 2, 0)] - x[max(n - 1, 0)] + 0.7 * noise() + 5.0 for n in range(count)])

print(f"# scipy {scipy.__version__}: csd, welch(scaling='density', return_onesided=True, average='mean'); tests/golden/frf_scipy.py")
print("signal", rate, count)
for a, b in zip(x, y):
    print(repr(float(a)), repr(float(b)))
for window, name in (("hann", "hann"), ("hamming", "hamming"), ("blackman", "blackman"), ("boxcar", "rectangular")):
    for length, overlap, detrend, trend in ((50, 25, "constant", "mean"), (64, 48, "linear", "line"), (36, 0, False, "none")):
        options = dict(fs=rate, window=window, nperseg=length, noverlap=overlap, detrend=detrend)
        f, xx = signal.welch(x, **options)
        f, yy = signal.welch(y, **options)
        f, xy = signal.csd(x, y, **options)
        print("spectra", name, length, length - overlap, trend, len(f))
        for row in zip(f, xx, yy, xy.real, xy.imag):
            print(*[repr(float(value)) for value in row])
