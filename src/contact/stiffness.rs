//! Generalized stiffness of journal and bearing.
//! ```text
//! K = 4 / (3 (σ_i + σ_j)) · √R       (paper, eq. 5)
//! σ_k = (1 − ν_k²)/E_k               (paper, eq. 6)
//! ```
//! The paper prints R = R_i R_j/(R_i + R_j), which is that of two spheres side by side. A journal
//! lies *inside* its bearing: R = R_b R_j/(R_b − R_j), 4.4 times stiffer at R_b = 10 mm, c = 1 mm.
//! Both are offered by name; the paper's own is the default of its cases. On a plane, where R_b is
//! infinite, both are R = R_j.

use crate::scalar::Scalar;

/// Elastic constants of one material.
#[derive(Debug, Clone, Copy)]
pub struct Material<S> {
    /// Young's modulus E (Pa).
    pub young: S,
    /// Poisson's ratio ν.
    pub poisson: S,
}

impl<S: Scalar> Material<S> {
    /// σ = (1 − ν²)/E (1/Pa), eq. 6.
    fn compliance(&self) -> S {
        (S::one() - self.poisson * self.poisson) / self.young
    }
}

/// E* (Pa) of two materials: 1/E* = σ_i + σ_j.
pub fn composite<S: Scalar>(materials: [Material<S>; 2]) -> S {
    let [sigma_i, sigma_j] = materials.map(|material| material.compliance());
    S::one() / (sigma_i + sigma_j)
}

/// K (N/m^1.5) of two materials and an effective radius R (m), eq. 5.
fn hertz<S: Scalar>(materials: [Material<S>; 2], radius: S) -> S {
    let [sigma_i, sigma_j] = materials.map(|material| material.compliance());
    S::ratio(4, 3) / (sigma_i + sigma_j) * radius.sqrt()
}

/// K (N/m^1.5) as the paper prints it, from the radii (m) of bearing and journal.
pub fn hertz_printed<S: Scalar>(materials: [Material<S>; 2], bearing: S, journal: S) -> S {
    hertz(
        materials,
        if bearing.is_finite() { bearing * journal / (bearing + journal) } else { journal },
    )
}

/// K (N/m^1.5) of a journal inside its bearing, from their radii (m).
pub fn hertz_internal<S: Scalar>(materials: [Material<S>; 2], bearing: S, journal: S) -> S {
    hertz(
        materials,
        if bearing.is_finite() { bearing * journal / (bearing - journal) } else { journal },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::F256;

    fn material(young: &str, poisson: &str) -> Material<F256> {
        Material { young: F256::parse(young).unwrap(), poisson: F256::parse(poisson).unwrap() }
    }

    fn steel() -> [Material<F256>; 2] {
        [material("207e9", "0.3"); 2]
    }

    #[test]
    fn the_papers_stiffness_comes_out_to_all_digits() {
        let [bearing, journal] = ["0.010", "0.009"].map(|r| F256::parse(r).unwrap());
        let k = hertz_printed(steel(), bearing, journal);
        let exact = F256::parse("1.04371553651002825e10").unwrap();
        assert!(((k - exact) / exact).abs().to_f64() < 1e-17);
    }

    #[test]
    fn a_journal_inside_its_bearing_is_stiffer_by_the_root_of_sum_over_difference() {
        let [bearing, journal] = ["0.010", "0.0095"].map(|r| F256::parse(r).unwrap());
        let ratio =
            hertz_internal(steel(), bearing, journal) / hertz_printed(steel(), bearing, journal);
        assert!((ratio * ratio - F256::from(39)).abs().to_f64() < 1e-60);
    }

    #[test]
    fn two_materials_yield_one_after_the_other() {
        let [bearing, journal] = ["0.010", "0.009"].map(|r| F256::parse(r).unwrap());
        let k = |materials| hertz_printed(materials, bearing, journal);
        let [steel, bronze] = [material("207e9", "0.3"), material("110e9", "0.34")];
        let mixed = k([steel, bronze]);
        // 1/K = (1/K of steel on steel + 1/K of bronze on bronze)/2
        let one = F256::one();
        let series = (one / k([steel; 2]) + one / k([bronze; 2])) / F256::from(2);
        assert!((mixed * series - one).abs().to_f64() < 1e-60);
        assert!((mixed - k([bronze, steel])).abs().to_f64() < 1e-60 * mixed.to_f64());
        // (4/3) √(9/1900) / (0.91/207e9 + 0.8844/110e9), worked out apart from this program
        let exact = F256::parse("7.379004134935793393538e9").unwrap();
        assert!(((mixed - exact) / exact).abs().to_f64() < 1e-20, "{}", mixed.to_f64());
    }

    #[test]
    fn a_steel_journal_in_a_rigid_bearing_is_twice_as_stiff_as_in_a_steel_one() {
        let [bearing, journal] = ["0.010", "0.009"].map(|r| F256::parse(r).unwrap());
        let [steel, _] = steel();
        let rigid = hertz_internal([material("1e90", "0.3"), steel], bearing, journal);
        let ratio = rigid / hertz_internal([steel; 2], bearing, journal);
        assert!((ratio - F256::from(2)).abs().to_f64() < 1e-60);
    }
}
