# SPDX-License-Identifier: BSD-3-Clause
"""What each of our aircraft in JSBSim has: its mass, a planet that neither turns nor curves within a flight, and units."""

FT = 0.3048
LBF = 4.4482216152605
SLUG = LBF / FT  # [kg]: a pound-force gives it 1 ft/s^2
SLUG_FT2 = SLUG * FT ** 2
LB_PER_SLUG = 32.174049  # JSBSim's own, so that its masses are ours to all digits
FLAT_RADIUS_M = 1e9  # 300 m of way curve by 0.05 mm
ORIGIN = "<x>0</x><y>0</y><z>0</z>"


def planet(gravity_m_s2: float) -> str:
    return f"""<planet name="flat"><semimajor_axis unit="FT">{FLAT_RADIUS_M / FT!r}</semimajor_axis>
<semiminor_axis unit="FT">{FLAT_RADIUS_M / FT!r}</semiminor_axis><rotation_rate unit="RAD/SEC">0</rotation_rate>
<GM unit="FT3/SEC2">{gravity_m_s2 * FLAT_RADIUS_M ** 2 / FT ** 3!r}</GM><J2>0</J2></planet>
"""


def mass_balance(mass_kg: float, inertia_kg_m2: dict) -> str:
    """The inertia has keys xx to yz, of the matrix in axes forward, right, down."""
    # JSBSim wants the integrals of x y dm etc. in axes aft, right, up; our matrix holds their negatives.
    sign = {"xx": 1.0, "yy": 1.0, "zz": 1.0, "xy": 1.0, "xz": -1.0, "yz": 1.0}
    inertia = "".join(f'<i{key} unit="SLUG*FT2">{sign[key] * inertia_kg_m2.get(key, 0.0) / SLUG_FT2!r}</i{key}>'
                      for key in sign)
    return f"""<mass_balance negated_crossproduct_inertia="false">{inertia}<emptywt unit="LBS">{mass_kg / SLUG * LB_PER_SLUG!r}</emptywt>
<location name="CG" unit="IN">{ORIGIN}</location></mass_balance>
"""


def metrics(area_m2: float = 1.0, span_m: float = 1.0, chord_m: float = 1.0) -> str:
    return f"""<metrics><wingarea unit="FT2">{area_m2 / FT ** 2!r}</wingarea>
<wingspan unit="FT">{span_m / FT!r}</wingspan><chord unit="FT">{chord_m / FT!r}</chord>
<location name="AERORP" unit="IN">{ORIGIN}</location></metrics>
"""
