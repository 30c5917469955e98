//! Generalized stiffness of journal and bearing.
//! ```text
//! K = 4 / (3 (σ_i + σ_j)) · √R       (paper, eq. 5)
//! σ_k = (1 − ν_k²)/E_k               (paper, eq. 6)
//! ```
//! The paper prints R = R_i R_j/(R_i + R_j), which is that of two spheres side by side. A journal
//! lies *inside* its bearing: R = R_b R_j/(R_b − R_j), 4.4 times stiffer at R_b = 10 mm, c = 1 mm.
//! Both are offered by name; the paper's own is the default of its cases.

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

/// K (N/m^1.5) of two equal materials and an effective radius R (m), eq. 5.
fn hertz<S: Scalar>(material: Material<S>, radius: S) -> S {
    let sigma = material.compliance();
    S::ratio(4, 3) / (sigma + sigma) * radius.sqrt()
}

/// K (N/m^1.5) as the paper prints it, from the radii (m) of bearing and journal.
pub fn hertz_printed<S: Scalar>(material: Material<S>, bearing: S, journal: S) -> S {
    hertz(material, bearing * journal / (bearing + journal))
}

/// K (N/m^1.5) of a journal inside its bearing, from their radii (m).
pub fn hertz_internal<S: Scalar>(material: Material<S>, bearing: S, journal: S) -> S {
    hertz(material, bearing * journal / (bearing - journal))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::F256;

    fn steel() -> Material<F256> {
        Material { young: F256::parse("207e9").unwrap(), poisson: F256::parse("0.3").unwrap() }
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
}
