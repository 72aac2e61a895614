"""The paper's figures 5 and 6, and those that show where its equations hold."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, NullFormatter

from spacerobot.theory import table1
from spacerobot.view.paper.data import Condition, PaperData
from spacerobot.view.plotting import BLACK, BLUE, GREY, MARKERS, ORANGE, SERIES, SKY, VERMILION, canvas, style

_MASS_LABEL = r"$m_w + m_t$ [kg]"


def _dots(axes: Axes, conditions: list[Condition], value: str, index: int, label: str | None = None) -> None:
    axes.errorbar(
        [c.target_mass + table1.WRIST_MASS for c in conditions],
        [getattr(c, value) for c in conditions],
        yerr=[getattr(c, f"{value}_sd") for c in conditions],
        fmt=MARKERS[index],
        color=SERIES[index],
        markerfacecolor="white",
        markeredgewidth=1.4,
        markersize=6,
        elinewidth=1.2,
        label=label,
        zorder=3,
    )


def contact_times(data: PaperData) -> Figure:
    """Fig. 5: contact time over m_w + m_t, theory and simulated trials."""
    with style():
        figure = canvas(7.4, 4.8)
        axes = figure.subplots()
        for i, curve in enumerate(data.curves):
            axes.plot(curve.lumped_mass, curve.time_simplified, color=SERIES[i])
            axes.plot(curve.lumped_mass, curve.time_exact, color=SERIES[i], linestyle=(0, (4, 2)))
            _dots(axes, [c for c in data.conditions if c.stiffness == curve.stiffness], "contact_time", i)
            axes.annotate(
                f"{curve.stiffness:g} N/m",
                (curve.lumped_mass[-1], curve.time_simplified[-1]),
                xytext=(5, 0),
                textcoords="offset points",
                color=SERIES[i],
                va="center",
            )
        axes.set(xlabel=_MASS_LABEL, ylabel="contact time [s]", ylim=(0, None), xlim=(3, 60))
        axes.set_title("Fig. 5: contact time")
        axes.legend(handles=_key(), loc="upper left")
        return figure


def restitutions(data: PaperData) -> Figure:
    """Fig. 6: restitution over m_w + m_t, theory and simulated trials, a panel for each spring."""
    with style():
        figure = canvas(8.4, 6.6)
        panels = figure.subplots(2, 2, sharex=True, sharey=True)
        for i, (curve, axes) in enumerate(zip(data.curves, panels.flat, strict=True)):
            axes.plot(curve.lumped_mass, curve.e_wrist, color=GREY, linestyle=":")
            axes.plot(curve.lumped_mass, curve.e_simplified, color=SERIES[i])
            axes.plot(curve.lumped_mass, curve.e_exact, color=SERIES[i], linestyle=(0, (4, 2)))
            _dots(axes, [c for c in data.conditions if c.stiffness == curve.stiffness], "restitution", i)
            axes.set_title(f"$k_w$ = {curve.stiffness:g} N/m")
            axes.set(xlim=(3, 61), ylim=(0.55, 1.0))
        for axes in panels[1]:
            axes.set_xlabel(_MASS_LABEL)
        for axes in panels[:, 0]:
            axes.set_ylabel("restitution e")
        wrist = Line2D([], [], color=GREY, linestyle=":", label="simplified, $c_w$ alone (Eq. 18)")
        figure.legend(handles=[*_key(), wrist], loc="outside lower center", ncols=2)
        figure.suptitle("Fig. 6: restitution", fontsize=11)
        return figure


def _key() -> list[Line2D]:
    return [
        Line2D([], [], color=BLACK, label=r"simplified, $c_w + c_{eq}$ (Eqs. 16, 18)"),
        Line2D([], [], color=BLACK, linestyle=(0, (4, 2)), label=r"exact, $c_w + c_{eq}$ (Eqs. 2 to 4)"),
        Line2D(
            [],
            [],
            color=BLACK,
            marker="o",
            markerfacecolor="white",
            linestyle="none",
            label="simulated, Coulomb friction: mean ± s.d. of 5",
        ),
    ]


def frequency(data: PaperData) -> Figure:
    """Eq. 5 as printed against the eigenfrequency."""
    check = data.frequencies
    with style():
        figure = canvas(7.4, 4.4)
        axes = figure.subplots()
        axes.semilogx(check.contact_stiffness, check.exact, color=BLUE, label="exact: eigenfrequency of Eqs. 2 to 4")
        axes.axhline(check.limit, color=BLACK, linestyle=(0, (4, 2)), linewidth=1.1, label="Eqs. 9 and 10")
        axes.semilogx(
            check.contact_stiffness,
            check.printed_reading,
            color=VERMILION,
            linestyle="-.",
            label="Eq. 5 as printed (a reading that meets its known value)",
        )
        axes.plot(
            [table1.CONTACT_STIFFNESS],
            [check.known],
            marker="s",
            color=VERMILION,
            linestyle="none",
            label=f"Eq. 5 as printed, known value {check.known:g} rad/s",
        )
        axes.plot([table1.CONTACT_STIFFNESS], [check.exact_there], marker="o", color=BLUE, linestyle="none")
        axes.annotate(
            f"{check.exact_there:.2f} rad/s",
            (table1.CONTACT_STIFFNESS, check.exact_there),
            xytext=(6, -14),
            textcoords="offset points",
            color=BLUE,
        )
        axes.set(xlabel="contact stiffness $k_c$ [N/m]", ylabel="lower natural frequency [rad/s]", ylim=(0, 24))
        axes.set_title("Eq. 5 as printed is not the natural frequency (M = 1e9, 0.7, 9 kg, 530 N/m)")
        axes.legend(loc="center right", bbox_to_anchor=(1.0, 0.58))
        return figure


def adhesion(data: PaperData) -> Figure:
    """The force on the target up to the end of Eq. 14, and what a contact that cannot pull does."""
    check = data.pull
    with style():
        figure = canvas(7.4, 4.4)
        axes = figure.subplots()
        axes.axhline(0, color=BLACK, linewidth=0.8)
        axes.plot(check.time, check.exact, color=SKY, linewidth=1.0, label="exact, contact cannot pull (Eqs. 2 to 4)")
        axes.plot(check.time, check.simplified, color=BLUE, label="simplified (Eqs. 12 to 14)")
        axes.fill_between(
            check.time,
            check.simplified,
            0,
            where=check.simplified < 0,
            color=ORANGE,
            alpha=0.6,
            label="the contact would have to pull",
        )
        axes.annotate(
            "force zero",
            (check.adhesion.start, 0),
            xytext=(-86, -26),
            textcoords="offset points",
            arrowprops={"arrowstyle": "->", "color": BLACK},
        )
        axes.annotate(
            "end of Eq. 14",
            (check.adhesion.end, 0),
            xytext=(-2, 40),
            textcoords="offset points",
            arrowprops={"arrowstyle": "->", "color": BLACK},
        )
        axes.set(
            xlabel="time after touch [s]", ylabel="force on the target [N]", xlim=(0, check.time[-1]), ylim=(-3.5, None)
        )
        axes.set_title(f"Before the end of Eq. 14 the force pulls ({check.stiffness:g} N/m, {check.target_mass:g} kg)")
        axes.legend(loc="upper right")
        return figure


def hand_mass(data: PaperData) -> Figure:
    """M -> infinity: m~ of Eq. 10, and contact time of the reduced and of the exact model."""
    check = data.hand_mass
    with style():
        figure = canvas(8.6, 4.0)
        left, right = figure.subplots(1, 2)
        left.semilogx(check.hand_mass, check.reduced_mass, color=BLUE, label=r"$\tilde{m}$ of Eq. 10")
        left.axhline(
            check.lumped_mass,
            color=BLACK,
            linestyle=(0, (4, 2)),
            linewidth=1.1,
            label=f"$m_w + m_t$ = {check.lumped_mass:g} kg",
        )
        left.set(xlabel="equivalent mass of the arm $M$ [kg]", ylabel=r"$\tilde{m}$ [kg]", ylim=(0, 11))
        left.set_title(r"$\tilde{m} \to m_w + m_t$")
        left.legend(loc="lower right")
        right.loglog(check.hand_mass, check.time_simplified, color=BLUE, label="simplified (Eqs. 10, 16)")
        right.loglog(
            check.hand_mass,
            check.time_exact,
            color=VERMILION,
            linestyle="none",
            marker="o",
            markersize=4,
            markevery=3,
            label="exact (Eqs. 2 to 4, end of Eq. 14)",
        )
        guide = check.hand_mass > 100
        right.loglog(
            check.hand_mass[guide],
            0.5 * check.lumped_mass / check.hand_mass[guide],
            color=BLACK,
            linestyle=":",
            label="$(m_w + m_t)/(2 M)$",
        )
        right.set(xlabel="equivalent mass of the arm $M$ [kg]", ylabel="contact time short of a locked arm's, relative")
        right.set_title("first order in $1/M$")
        right.legend(loc="lower left")
        return figure


def servo_arm(data: PaperData) -> Figure:
    """The PA10-like arm on the ground, its servos ever stiffer: 1/m_app -> 0 and m~ -> m_w + m_t."""
    check = data.servo
    with style():
        figure = canvas(8.6, 4.0)
        left, right = figure.subplots(1, 2)
        left.loglog(check.stiffness, -check.mobility, color=BLUE, marker="o", markersize=4, markevery=2)
        left.set(
            xlabel="stiffness of each joint's servo [N m/rad]", ylabel=r"$-\mathrm{Re}\,1/m_{app}$ at contact [1/kg]"
        )
        left.set_title(r"$1/m_{app} \to 0$, the arm a spring")
        gap = check.reduced_mass / check.lumped_mass - 1.0
        right.loglog(
            check.stiffness,
            gap,
            color=VERMILION,
            marker="o",
            markersize=4,
            linestyle="none",
            label=r"from $m_{app}$ of the arm",
        )
        right.loglog(check.stiffness, check.expected, color=BLUE, label=r"from $-\omega^2/K_{tip}$")
        right.set(xlabel="stiffness of each joint's servo [N m/rad]", ylabel=r"$\tilde{m}/(m_w + m_t) - 1$")
        right.set_title(r"$\tilde{m} \to m_w + m_t$ = " + f"{check.lumped_mass:g} kg")
        right.legend(loc="upper right")
        return figure


def speed(data: PaperData) -> Figure:
    """Restitution over the speed: Coulomb friction against the constant damping that stands for it."""
    check = data.speed
    soft = [t for t in data.trials if t.stiffness == 530.0 and t.target_mass == 9.0]
    with style():
        figure = canvas(7.4, 4.4)
        axes = figure.subplots()
        axes.plot(check.speed, check.coulomb, color=BLUE, label="Coulomb friction, end of Eq. 14")
        axes.plot(
            check.speed,
            check.coulomb_released,
            color=SKY,
            linestyle=(0, (4, 2)),
            label="Coulomb friction, contact that cannot pull",
        )
        axes.axhline(check.constant, color=VERMILION, linestyle="-.", label=r"constant $c_w + c_{eq}$ (Eq. 18)")
        axes.axvline(check.smallest_speed, color=GREY, linestyle=":", linewidth=1.0)
        axes.annotate(
            "no return below this speed\n(end of Eq. 14)",
            (check.smallest_speed, 0.12),
            xytext=(8, 0),
            textcoords="offset points",
            color=GREY,
        )
        axes.plot(
            [t.speed for t in soft],
            [t.restitution for t in soft],
            color=BLACK,
            marker="o",
            markerfacecolor="white",
            linestyle="none",
            label="simulated trials of Fig. 6 (wrist of 0.7 kg)",
        )
        axes.set(xlabel="speed of approach [m/s]", ylabel="restitution e", xlim=(0, 0.3), ylim=(0, 1))
        axes.set_title(
            r"A constant $c_{eq}$ fits one speed "
            f"(530 N/m, 9.7 kg, F = {check.friction:.2f} N)"
        )
        axes.legend(loc="lower right")
        return figure


def assumption_costs(data: PaperData) -> Figure:
    """What breaking each assumption costs, in the two conditions that lie furthest apart."""
    keys = list(data.findings)
    chosen = (keys[0], keys[-1])
    numbers = np.arange(1, 9)
    with style():
        figure = canvas(8.6, 4.6)
        left, right = figure.subplots(1, 2, sharey=True)
        for offset, key, color, hatch in zip((-0.2, 0.2), chosen, (BLUE, ORANGE), ("", "///"), strict=True):
            found = data.findings[key]
            label = f"{key[0]:g} N/m, {key[1]:g} kg"
            for axes, values in (
                (left, [100 * f.contact_time for f in found]),
                (right, [f.restitution for f in found]),
            ):
                axes.barh(
                    numbers + offset, values, height=0.38, color=color, hatch=hatch, edgecolor="white", label=label
                )
        for axes in (left, right):
            axes.set_axisbelow(True)
            axes.axvline(0, color=BLACK, linewidth=0.8)
        left.set_yticks(numbers, [f"{n}  {name}" for n, name in zip(numbers, _SHORT, strict=True)])
        left.invert_yaxis()
        left.set(xlabel="change of contact time [%]")
        right.set(xlabel="change of restitution")
        left.set_title("What breaking an assumption costs", loc="left")
        right.legend(loc="lower left")
        return figure


_SHORT = (
    "point mass",
    "constant M",
    "stiff joints",
    "linear spring",
    r"$\omega_c \gg \omega_w$",
    "light wrist",
    "friction as $c_{eq}$, half speed",
    "end of Eq. 14",
)


def assumption_sweeps(data: PaperData) -> Figure:
    """Four assumptions broken by degrees."""
    with style():
        figure = canvas(8.6, 6.8)
        panels = figure.subplots(2, 2)
        for sweep, axes in zip(data.sweeps, panels.flat, strict=True):
            if sweep.at is not None:
                axes.axvspan(*sweep.at, color=SKY, alpha=0.22, linewidth=0)
            axes.axhline(0, color=BLACK, linewidth=0.8)
            axes.plot(sweep.x, sweep.expected, color=BLUE, label="closed form")
            axes.plot(
                sweep.x,
                sweep.found,
                color=VERMILION,
                marker="o",
                markersize=4,
                linestyle="none",
                label="solved without the assumption",
            )
            if sweep.at is not None:
                axes.set_xscale("log")
                axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
                axes.xaxis.set_minor_formatter(NullFormatter())
            if sweep.number == 5:
                axes.set_xticks([2, 5, 10, 20, 40])
            axes.set(xlabel=_typeset(sweep.x_label), ylabel=sweep.y_label)
            axes.set_title(f"{sweep.number}: {_SHORT[sweep.number - 1]}\n{_typeset(sweep.condition)}", fontsize=8.5)
        handles, labels = panels[0, 0].get_legend_handles_labels()
        shade = Line2D([], [], color=SKY, alpha=0.5, linewidth=7, label="range of Table 1")
        panels[0, 0].legend([*handles, shade], [*labels, "range of Table 1"], loc="lower left")
        return figure


def _typeset(text: str) -> str:
    """Symbols of a plain text set as mathematics."""
    for plain, mathematics in (
        ("omega_c/omega_w", r"$\omega_c/\omega_w$"),
        ("m_w/m_t", "$m_w/m_t$"),
        ("m_w + m_t", "$m_w + m_t$"),
        ("/k_w", "/$k_w$"),
    ):
        text = text.replace(plain, mathematics)
    return text


FIGURES: dict[str, Callable[[PaperData], Figure]] = {
    "fig5_contact_time": contact_times,
    "fig6_restitution": restitutions,
    "eq5_frequency": frequency,
    "eq14_adhesion": adhesion,
    "eq10_hand_mass": hand_mass,
    "eq10_servo_arm": servo_arm,
    "speed_dependence": speed,
    "assumption_costs": assumption_costs,
    "assumption_sweeps": assumption_sweeps,
}
"""File name (without suffix) -> drawing."""
