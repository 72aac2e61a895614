"""The equations of Uyama et al. (i-SAIRAS 2012) by number, and closed forms of contact. Needs only numpy."""
