"""Makes the maps beside it, with healpy 1.20 and astropy 8.0. Value of pixel p: p + 0.25 and so on."""
import healpy
import numpy as np
from astropy.io import fits

def pixels(nside):
    return np.arange(12 * nside**2)

p = pixels(4)
i, q, u = p + 0.25, p * 2.0, -p / 4.0
i[7] = healpy.UNSEEN
healpy.write_map("stokes_ring_f32.fits", [i, q, u], coord="G", dtype=np.float32, overwrite=True)

healpy.write_map("named_nested_f64.fits", [pixels(2) / 3, pixels(2) * 1.0], nest=True, coord="E",
                 column_names=["HITS", "SIGMA"], column_units=["1", "K"], dtype=np.float64, overwrite=True)

healpy.write_map("packed_ring_i16.fits", pixels(16) - 1000, dtype=np.int16, overwrite=True)

part = np.full(192, healpy.UNSEEN)
part[150:170] = 1.5
healpy.write_map("partial.fits", part, partial=True, coord="E", overwrite=True)

# An image first, then a table of unsigned integers with a null and a column of text.
columns = [
    fits.Column("LABEL", "3A", array=[f"p{k:02}" for k in pixels(2)]),
    fits.Column("COUNT", "J", bzero=2**31, null=5, array=pixels(2).astype(np.uint32) + 2**31),
    fits.Column("HALF", "E", array=pixels(2) / 2),
]
table = fits.BinTableHDU.from_columns(columns, name="MAPS")
table.header.update(PIXTYPE="HEALPIX", ORDERING="RING", NSIDE=2, INDXSCHM="IMPLICIT",
                    COORDSYS="ECLIPTIC", POLCCONV="IAU")
image = fits.ImageHDU(np.zeros((3, 5), np.int16))
fits.HDUList([fits.PrimaryHDU(), image, table]).writeto("scaled_second.fits", overwrite=True)
